-- What a store of any earlier form becomes; {longest} and {most} are filled in.

INSERT INTO axiscal.form VALUES (4);
CREATE TABLE IF NOT EXISTS axiscal.seen (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, record uuid NOT NULL REFERENCES axiscal.campaigns,
    copy text NOT NULL, campaign uuid NOT NULL, number bigint NOT NULL, at timestamptz NOT NULL DEFAULT now(),
    writer text NOT NULL DEFAULT session_user);
CREATE INDEX IF NOT EXISTS seen_record_copy_id_idx ON axiscal.seen (record, copy, id);
ALTER TABLE axiscal.events DROP CONSTRAINT IF EXISTS events_pkey CASCADE;
CREATE INDEX IF NOT EXISTS events_in_order ON axiscal.events (campaign, number);
CREATE TABLE IF NOT EXISTS axiscal.aside (
    campaign uuid, number bigint, digest text, at timestamptz NOT NULL DEFAULT now(), PRIMARY KEY (campaign, digest));
CREATE OR REPLACE VIEW axiscal.standing AS SELECT * FROM axiscal.events AS e WHERE NOT EXISTS (
    SELECT FROM axiscal.aside AS a WHERE a.campaign = e.campaign AND a.digest = e.digest);
CREATE OR REPLACE FUNCTION axiscal.quarantine(campaign uuid, first bigint) RETURNS bigint LANGUAGE plpgsql AS $body$
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
DROP FUNCTION IF EXISTS axiscal.append(uuid, bigint, bigint, text[], text[], text[], text[]);
CREATE OR REPLACE FUNCTION axiscal.append(
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
    IF (SELECT max(length(p)) FROM unnest($4) AS p) > {longest} OR cardinality($3) > {most} THEN
        RAISE EXCEPTION 'more than {most} events at once, or one of more than {longest} letters';
    END IF;
    IF wrong IS NOT NULL THEN
        RAISE EXCEPTION 'event % is none: its kind, its time or what it says cannot be', $2 + wrong;
    END IF;
    INSERT INTO axiscal.events (campaign, number, kind, payload, at, digest)
        SELECT $1, $2 + e.n, e.kind, e.payload, e.at, e.digest
        FROM unnest($3, $4, $5, $6) WITH ORDINALITY AS e (kind, payload, at, digest, n) ORDER BY e.n;
END $body$;
DROP FUNCTION IF EXISTS axiscal.enter(uuid, text, uuid, bigint);
CREATE OR REPLACE FUNCTION axiscal.enter(id uuid, name text, branch_of uuid, branch_at bigint,
    kinds text[], payloads text[], times text[], digests text[]) RETURNS void
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $body$
BEGIN
    IF ($2 ~ E'[[:cntrl:]/\\\\:*?"<>|]' OR $2 ~ '^[-. ]' OR $2 ~ '[. ]$' OR length($2) NOT BETWEEN 1 AND 100
        OR $2 ~ E'[\\u00ad\\u200b-\\u200f\\u2028-\\u202e\\u2060-\\u2069\\ufeff]') IS NOT FALSE THEN
        RAISE EXCEPTION 'a campaign cannot have this name';
    END IF;
    IF $3 IS NOT NULL AND NOT EXISTS (SELECT FROM axiscal.standing AS e JOIN axiscal.campaigns AS c ON c.id = e.campaign
        WHERE c.id = $3 AND c.name = $2 AND e.number = $4) THEN
        RAISE EXCEPTION 'a branch needs the event that it follows, and the name of its campaign';
    END IF;
    IF $3 IS NULL AND EXISTS (SELECT FROM axiscal.campaigns AS c WHERE c.branch_of IS NULL AND c.id <> $1
        AND lower(c.name) = lower($2) AND EXISTS (SELECT FROM axiscal.events AS e WHERE e.campaign = c.id)) THEN
        RAISE EXCEPTION 'another campaign has this name';
    END IF;
    IF coalesce(cardinality($5), 0) = 0 THEN
        RAISE EXCEPTION 'a campaign begins with an event';
    END IF;
    INSERT INTO axiscal.campaigns VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING;
    PERFORM axiscal.append($1, coalesce($4, 0), $5, $6, $7, $8);
END $body$;
