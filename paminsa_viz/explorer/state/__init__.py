"""What a session holds, as plain data: its settings, its jobs and what came of them."""
