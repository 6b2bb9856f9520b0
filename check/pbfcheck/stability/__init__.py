"""Verdicts on the stiff and extreme cases, from their dumps and facts. A case's judge is a function of its
files in the module of its family; `table.JUDGES` has them all."""
