"""The ABI of the public headers as data, and what is written from it."""
