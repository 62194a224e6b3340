-- The first form of a store.
CREATE SCHEMA axiscal;
CREATE TABLE axiscal.form (number integer PRIMARY KEY);
INSERT INTO axiscal.form VALUES (1);
CREATE TABLE axiscal.campaigns (
    id uuid PRIMARY KEY, name text NOT NULL, branch_of uuid REFERENCES axiscal.campaigns, branch_at bigint,
    CHECK ((branch_of IS NULL) = (branch_at IS NULL)), CHECK (branch_of <> id), CHECK (branch_at > 0));
CREATE INDEX ON axiscal.campaigns (name);
CREATE TABLE axiscal.events (
    campaign uuid REFERENCES axiscal.campaigns, number bigint CHECK (number > 0), kind text NOT NULL,
    payload text NOT NULL, at text NOT NULL, digest text NOT NULL, writer text NOT NULL DEFAULT session_user,
    PRIMARY KEY (campaign, number));
CREATE FUNCTION axiscal.refuse() RETURNS trigger LANGUAGE plpgsql AS $body$
BEGIN
    RAISE EXCEPTION 'events are only ever added' USING ERRCODE = '42501';
END $body$;
CREATE FUNCTION axiscal.follow() RETURNS trigger LANGUAGE plpgsql AS $body$
DECLARE
    before text;
BEGIN
    SELECT digest INTO before FROM axiscal.events WHERE campaign = NEW.campaign AND number = NEW.number - 1;
    IF before IS NULL THEN
        SELECT e.digest INTO before FROM axiscal.campaigns AS c
            JOIN axiscal.events AS e ON e.campaign = c.branch_of AND e.number = c.branch_at
            WHERE c.id = NEW.campaign AND c.branch_at = NEW.number - 1;
    END IF;
    IF before IS NULL AND NEW.number = 1
        AND EXISTS (SELECT FROM axiscal.campaigns WHERE id = NEW.campaign AND branch_of IS NULL) THEN
        before := '0000000000000000000000000000000000000000000000000000000000000000';
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
CREATE TRIGGER follow BEFORE INSERT ON axiscal.events FOR EACH ROW EXECUTE FUNCTION axiscal.follow();
CREATE TRIGGER keep BEFORE UPDATE OR DELETE ON axiscal.campaigns FOR EACH ROW EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep_all BEFORE TRUNCATE ON axiscal.campaigns FOR EACH STATEMENT EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep BEFORE UPDATE OR DELETE ON axiscal.events FOR EACH ROW EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep_all BEFORE TRUNCATE ON axiscal.events FOR EACH STATEMENT EXECUTE FUNCTION axiscal.refuse();
