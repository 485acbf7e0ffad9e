"""The parts of every report: pages, pictures, rows of numbers."""
