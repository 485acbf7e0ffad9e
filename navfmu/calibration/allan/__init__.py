"""Allan variances of inertial sensors at rest, and the error terms that make them."""
