"""Design files, share codes, examples."""
