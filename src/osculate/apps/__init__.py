"""Who uses it: thin adapters over the same calls; the command line."""
