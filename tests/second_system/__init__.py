"""A second system, of other people as it were: three components and a report file, without a line in the package."""
