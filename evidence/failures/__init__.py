"""What the analysis of failures is made of: its lines, what was injected for them, what was seen, a picture."""
