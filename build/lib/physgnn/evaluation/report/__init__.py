"""What an evaluation found, as tables, figures and one page."""
