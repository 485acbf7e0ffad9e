"""D. Gebre-Egziabher, Design and Performance Analysis of a Low-Cost Aided Dead Reckoning Navigator, Stanford, 2004."""
