"""What was recorded: variables, tasks, and graphs of operations."""
