"""What panels are made of: tables of entries, inputs, texts, charts, tasks."""
