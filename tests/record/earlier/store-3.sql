-- What the third form of a store adds to the second.
INSERT INTO axiscal.form VALUES (3);
CREATE TABLE IF NOT EXISTS axiscal.seen (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, record uuid NOT NULL REFERENCES axiscal.campaigns,
    copy text NOT NULL, campaign uuid NOT NULL, number bigint NOT NULL, at timestamptz NOT NULL DEFAULT now(),
    writer text NOT NULL DEFAULT session_user);
CREATE INDEX IF NOT EXISTS seen_record_copy_id_idx ON axiscal.seen (record, copy, id);
ALTER TABLE axiscal.events DROP CONSTRAINT IF EXISTS events_pkey CASCADE;
CREATE INDEX events_in_order ON axiscal.events (campaign, number);
CREATE TABLE axiscal.aside (
    campaign uuid, number bigint, digest text, at timestamptz NOT NULL DEFAULT now(), PRIMARY KEY (campaign, digest));
CREATE VIEW axiscal.standing AS SELECT * FROM axiscal.events AS e WHERE NOT EXISTS (
    SELECT FROM axiscal.aside AS a WHERE a.campaign = e.campaign AND a.digest = e.digest);
CREATE FUNCTION axiscal.quarantine(campaign uuid, first bigint) RETURNS bigint LANGUAGE plpgsql AS $body$
DECLARE
    count bigint;
BEGIN
    IF $2 < 2 OR EXISTS (SELECT FROM axiscal.campaigns AS c WHERE c.branch_of = $1 AND c.branch_at >= $2) THEN
        RAISE EXCEPTION 'what begins a campaign, or a branch follows, is not set aside';
    END IF;
    INSERT INTO axiscal.aside SELECT e.campaign, e.number, e.digest FROM axiscal.standing AS e
        WHERE e.campaign = $1 AND e.number >= $2;
    GET DIAGNOSTICS count = ROW_COUNT;
    RETURN count;
END $body$;
CREATE OR REPLACE FUNCTION axiscal.follow() RETURNS trigger LANGUAGE plpgsql AS $body$
DECLARE
    before text;
BEGIN
    IF current_setting('transaction_isolation') <> 'serializable' THEN
        RAISE EXCEPTION 'only a serializable transaction adds an event';
    END IF;
    IF EXISTS (SELECT FROM axiscal.standing AS e WHERE e.campaign = NEW.campaign AND e.number = NEW.number) THEN
        RAISE EXCEPTION 'there is an event % already', NEW.number USING ERRCODE = '23505';
    END IF;
    IF EXISTS (SELECT FROM axiscal.aside AS a WHERE a.campaign = NEW.campaign AND a.digest = NEW.digest) THEN
        RAISE EXCEPTION 'event % was set aside by whoever keeps the store', NEW.number;
    END IF;
    SELECT digest INTO before FROM axiscal.standing WHERE campaign = NEW.campaign AND number = NEW.number - 1;
    IF before IS NULL THEN
        SELECT e.digest INTO before FROM axiscal.campaigns AS c
            JOIN axiscal.standing AS e ON e.campaign = c.branch_of AND e.number = c.branch_at
            WHERE c.id = NEW.campaign AND c.branch_at = NEW.number - 1;
    END IF;
    IF before IS NULL AND NEW.number = 1
        AND EXISTS (SELECT FROM axiscal.campaigns WHERE id = NEW.campaign AND branch_of IS NULL) THEN
        before := repeat('0', 64);
    END IF;
    IF before IS NULL THEN
        RAISE EXCEPTION 'event % does not follow: there is no event before it', NEW.number;
    END IF;
    IF NEW.digest <> encode(sha256(convert_to(concat_ws(' ', before, NEW.kind, NEW.payload), 'UTF8')), 'hex') THEN
        RAISE EXCEPTION 'event % does not follow: its digest is another', NEW.number;
    END IF;
    NEW.writer := session_user;
    RETURN NEW;
END $body$;
DROP TRIGGER IF EXISTS follow ON axiscal.events;
CREATE TRIGGER follow BEFORE INSERT ON axiscal.events FOR EACH ROW EXECUTE FUNCTION axiscal.follow();
CREATE OR REPLACE FUNCTION axiscal.saw(record uuid, copy text, campaign uuid, number bigint) RETURNS void
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $body$
BEGIN
    IF NOT EXISTS (SELECT FROM axiscal.standing AS e WHERE e.campaign = $3 AND e.number = $4) THEN
        RAISE EXCEPTION 'the store has no such event';
    END IF;
    INSERT INTO axiscal.seen (record, copy, campaign, number) VALUES ($1, $2, $3, $4);
END $body$;
CREATE OR REPLACE FUNCTION axiscal.enter(id uuid, name text, branch_of uuid, branch_at bigint) RETURNS void
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $body$
BEGIN
    IF $2 !~ '[^[:space:]]' OR $2 ~ '[[:cntrl:]]' OR length($2) > 500 THEN
        RAISE EXCEPTION 'a campaign cannot have this name';
    END IF;
    IF $3 IS NOT NULL AND NOT EXISTS (SELECT FROM axiscal.standing AS e JOIN axiscal.campaigns AS c ON c.id = e.campaign
        WHERE c.id = $3 AND c.name = $2 AND e.number = $4) THEN
        RAISE EXCEPTION 'a branch needs the event that it follows, and the name of its campaign';
    END IF;
    INSERT INTO axiscal.campaigns VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING;
END $body$;
DROP FUNCTION IF EXISTS axiscal.append(uuid, bigint, bigint, text[], text[], text[], text[]);
CREATE FUNCTION axiscal.append(
    campaign uuid, last bigint, kinds text[], payloads text[], times text[], digests text[])
RETURNS void LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $body$
DECLARE
    wrong bigint;
BEGIN
    SELECT e.n INTO wrong FROM unnest($3, $4, $5) WITH ORDINALITY AS e (kind, payload, at, n)
        WHERE (e.kind ~ '^[a-z_]{1,40}$' AND (e.kind = 'created') = ($2 + e.n = 1)
        AND json_typeof(e.payload::json) = 'object' AND e.at ~
            '^[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9.]{2,9}[+-][0-9]{2}:[0-9]{2}$') IS NOT TRUE
        LIMIT 1;
    IF wrong IS NOT NULL THEN
        RAISE EXCEPTION 'event % is none: its kind, its time or what it says cannot be', $2 + wrong;
    END IF;
    INSERT INTO axiscal.events (campaign, number, kind, payload, at, digest)
        SELECT $1, $2 + e.n, e.kind, e.payload, e.at, e.digest
        FROM unnest($3, $4, $5, $6) WITH ORDINALITY AS e (kind, payload, at, digest, n) ORDER BY e.n;
END $body$;
