"""Images and label maps of every format, in one world: RAS+, mm."""
