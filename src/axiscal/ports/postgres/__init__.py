"""Events on a PostgreSQL server that laptops share; loaded only for a store."""
