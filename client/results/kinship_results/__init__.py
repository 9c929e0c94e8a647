"""Results of kinship-plan: comparisons, and the files and figures of a page. Nothing but Python's own library."""
