"""Many patients: each row of a table goes through the stages it asks for."""
