-- What the second form of a store adds to the first.
INSERT INTO axiscal.form VALUES (2);
CREATE TABLE axiscal.seen (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, record uuid NOT NULL REFERENCES axiscal.campaigns,
    copy text NOT NULL, campaign uuid NOT NULL, number bigint NOT NULL, at timestamptz NOT NULL DEFAULT now(),
    writer text NOT NULL DEFAULT session_user, FOREIGN KEY (campaign, number) REFERENCES axiscal.events);
CREATE INDEX ON axiscal.seen (record, copy, id);
CREATE FUNCTION axiscal.saw(record uuid, copy text, campaign uuid, number bigint) RETURNS void LANGUAGE sql
SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $body$
    INSERT INTO axiscal.seen (record, copy, campaign, number) VALUES ($1, $2, $3, $4);
$body$;
CREATE FUNCTION axiscal.enter(id uuid, name text, branch_of uuid, branch_at bigint) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $body$
BEGIN
    IF $2 !~ '[^[:space:]]' OR $2 ~ '[[:cntrl:]]' OR length($2) > 500 THEN
        RAISE EXCEPTION 'a campaign cannot have this name';
    END IF;
    IF $3 IS NOT NULL AND NOT EXISTS (SELECT FROM axiscal.events AS e JOIN axiscal.campaigns AS c ON c.id = e.campaign
        WHERE c.id = $3 AND c.name = $2 AND e.number = $4) THEN
        RAISE EXCEPTION 'a branch needs the event that it follows, and the name of its campaign';
    END IF;
    INSERT INTO axiscal.campaigns VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING;
END $body$;
CREATE FUNCTION axiscal.append(
    campaign uuid, held bigint, last bigint, kinds text[], payloads text[], times text[], digests text[])
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $body$
DECLARE
    wrong bigint;
BEGIN
    PERFORM pg_advisory_xact_lock($2);  -- what follows sees what others wrote until then
    SELECT e.n INTO wrong FROM unnest($4, $5, $6) WITH ORDINALITY AS e (kind, payload, at, n)
        WHERE (e.kind ~ '^[a-z_]{1,40}$' AND (e.kind = 'created') = ($3 + e.n = 1)
        AND json_typeof(e.payload::json) = 'object' AND e.at ~
            '^[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9.]{2,9}[+-][0-9]{2}:[0-9]{2}$') IS NOT TRUE
        LIMIT 1;
    IF wrong IS NOT NULL THEN
        RAISE EXCEPTION 'event % is none: its kind, its time or what it says cannot be', $3 + wrong;
    END IF;
    INSERT INTO axiscal.events (campaign, number, kind, payload, at, digest)
        SELECT $1, $3 + e.n, e.kind, e.payload, e.at, e.digest
        FROM unnest($4, $5, $6, $7) WITH ORDINALITY AS e (kind, payload, at, digest, n) ORDER BY e.n;
END $body$;
CREATE TRIGGER keep BEFORE UPDATE OR DELETE ON axiscal.seen FOR EACH ROW EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep_all BEFORE TRUNCATE ON axiscal.seen FOR EACH STATEMENT EXECUTE FUNCTION axiscal.refuse();
