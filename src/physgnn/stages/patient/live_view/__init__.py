"""The live view of one patient: a case opened, its states registered, saved."""
