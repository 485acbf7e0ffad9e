"""What recordings of sensors tell of their errors, as tables, pictures and parameter sets that FMUs take."""
