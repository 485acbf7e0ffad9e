"""What a component declares: variables, bundles, tasks, tables, requirements."""
