-- Who may read, and who may add by functions alone.

REVOKE ALL ON SCHEMA axiscal FROM PUBLIC;
GRANT USAGE ON SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
GRANT SELECT ON ALL TABLES IN SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
REVOKE INSERT ON ALL TABLES IN SCHEMA axiscal FROM axiscal_measurer;
REVOKE ALL ON ALL FUNCTIONS IN SCHEMA axiscal FROM PUBLIC;
GRANT EXECUTE ON FUNCTION axiscal.append, axiscal.enter, axiscal.saw TO axiscal_measurer;
