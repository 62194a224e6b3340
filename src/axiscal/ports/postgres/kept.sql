-- Nobody changes or deletes what a {table} holds.

DROP TRIGGER IF EXISTS keep ON axiscal.{table};
DROP TRIGGER IF EXISTS keep_all ON axiscal.{table};
CREATE TRIGGER keep BEFORE UPDATE OR DELETE ON axiscal.{table} FOR EACH ROW EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep_all BEFORE TRUNCATE ON axiscal.{table} FOR EACH STATEMENT EXECUTE FUNCTION axiscal.refuse();
