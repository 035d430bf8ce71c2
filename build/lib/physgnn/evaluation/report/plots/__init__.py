"""What a report draws: charts, three-dimensional views, panels."""
