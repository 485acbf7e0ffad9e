"""What is written for tools that read SSP Traceability."""
