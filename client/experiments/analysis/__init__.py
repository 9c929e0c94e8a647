"""What the results of a study say: statistics, tables and figures. Nothing here plans."""
