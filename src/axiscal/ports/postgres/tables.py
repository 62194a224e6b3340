"""The tables of a store, what they refuse, and who may do what.

Nobody changes or deletes an event, its owner included: a trigger refuses it. What is inserted has to follow: the next
number of its campaign, and the hash chained over what stands before it, which the server computes itself. People add
by functions alone, which check kinds, texts, names and branches, so that no other client can do more. Of each copy of
a record that is brought together with the store it is kept how far it went: `seen`.
"""

from __future__ import annotations

from axiscal.exceptions import RecordError
from axiscal.ports.postgres.database import Database
from axiscal.record.log import EMPTY

FORM = 2
"""Of the tables; the first had neither what the store saw nor functions."""
_FIRST = f"""
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
        before := '{EMPTY}';
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
"""
_SECOND = """
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
"""
_KEPT = """
CREATE TRIGGER keep BEFORE UPDATE OR DELETE ON axiscal.{table} FOR EACH ROW EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep_all BEFORE TRUNCATE ON axiscal.{table} FOR EACH STATEMENT EXECUTE FUNCTION axiscal.refuse();
"""
_ROLE = "DO $body$ BEGIN CREATE ROLE {role} NOLOGIN; EXCEPTION WHEN duplicate_object THEN NULL; END $body$"
_RIGHTS = """
REVOKE ALL ON SCHEMA axiscal FROM PUBLIC;
GRANT USAGE ON SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
GRANT SELECT ON ALL TABLES IN SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
REVOKE INSERT ON ALL TABLES IN SCHEMA axiscal FROM axiscal_measurer;
REVOKE ALL ON ALL FUNCTIONS IN SCHEMA axiscal FROM PUBLIC;
GRANT EXECUTE ON FUNCTION axiscal.append, axiscal.enter TO axiscal_measurer;
GRANT EXECUTE ON FUNCTION axiscal.saw TO axiscal_measurer, axiscal_reader;
"""
ROLES = "axiscal_reader", "axiscal_measurer"
"""Who may read, and who may read and add; a person's account is made a member of one: GRANT axiscal_reader TO anna."""


def prepare(database: Database) -> bool:
    """Make a database a store, or one of an earlier form one of this; False where it is one.  Raises RecordError."""
    there = _there(database)
    form = _form(database) if there else 0
    if form >= FORM:
        refuse_other(database)
        return False
    with database.transaction("tables"):
        for role in ROLES:
            database.rows(_ROLE.format(role=role))
        if not there:
            _make(database, _FIRST, "campaigns", "events")
        _make(database, _SECOND, "seen")
        database.rows(_RIGHTS)
    return True


def refuse_other(database: Database) -> None:
    """Raise RecordError for a database that is no store, or one of another axiscal."""
    form = _form(database)
    if form < FORM:
        what = "This store was made by an earlier axiscal (form {form}; this one needs {known})"
        remedy = "Prepare it once more, as its owner: axiscal shop sync --prepare; what it holds stays"
        raise RecordError(what, remedy, database.address.shown, form=form, known=FORM)
    if form > FORM:
        what = "This store was made by a newer axiscal (form {form}; this one knows {known})"
        remedy = "Install the newer version; nothing was changed"
        raise RecordError(what, remedy, database.address.shown, form=form, known=FORM)


def _make(database: Database, script: str, *tables: str) -> None:
    """Run a script; nobody changes or deletes what the tables hold."""
    for each in (script, *(_KEPT.format(table=table) for table in tables)):
        database.rows(each)


def _form(database: Database) -> int:
    """Return the form of a store; one without is as new as can be."""
    form = database.rows("SELECT max(number) FROM axiscal.form")[0][0]
    return FORM + 1 if form is None else int(form)


def _there(database: Database) -> bool:
    return bool(database.rows("SELECT to_regclass('axiscal.form') IS NOT NULL")[0][0])
