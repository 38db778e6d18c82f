"""Motions on the page: what is planned, how it is played, what is plotted, and its simulation."""
