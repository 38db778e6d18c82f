"""Proofs that requirements hold over a whole workspace, and the largest such workspaces."""
