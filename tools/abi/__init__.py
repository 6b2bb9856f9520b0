"""The ABI of pbf.h as data, and what is written from it."""
