"""Events on a PostgreSQL server that laptops share; loaded only where a store is asked for."""
