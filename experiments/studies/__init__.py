"""One study a question, in a folder for what it is about."""
