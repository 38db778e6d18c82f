"""The features of the page, a folder each: actions, entries, texts, charts and layers."""
