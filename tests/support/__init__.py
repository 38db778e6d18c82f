"""What tests share, as a pytest plugin: fixtures, random robots, sessions without a browser."""
