"""Requirements on the page: what a person asks for, what is checked, and what is searched."""
