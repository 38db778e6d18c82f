"""Mutation tests: which small changes of the source the tests of its subpackage notice."""
