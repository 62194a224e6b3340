"""The tables of a store, what they refuse, and who may do what.

Nobody changes or deletes an event, its owner included: a trigger refuses it. What is inserted has to follow: the next
number of its campaign, and the hash chained over what stands before it, which the server computes itself. People add
by functions alone, which check kinds, texts, names and branches, so that no other client can do more. Of each copy of
a record that is brought together with the store it is kept how far it went: `seen`.

A client of a measurer's own can add an entry that is none, and then nobody can read what stands there. The owner sets
it and all behind it aside: the rows stay, and `standing` shows the others.

Nobody waits for anybody. A unique index would make writers wait for a client that keeps its transaction open, and so
would a lock. Therefore each transaction is serializable (Ports and Grittner, VLDB 2012): two that write the same number
never both end well, the first to end wins, and the other is tried again.
"""

from __future__ import annotations

from axiscal.exceptions import RecordError
from axiscal.ports.postgres.database import Database

FORM = 4
"""Of the tables; the first had no functions, in the second a client could keep others waiting, and in the third a
campaign could have no event, and any name."""
_FIRST = """
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
"""
_LONGEST, _MOST = 20_000_000, 200_000
"""Letters of an event, and events that come at once: ten times what the largest campaign has."""
_SESSIONS = 200
"""Connections that a store takes, where its owner has not said."""
_LIMIT = (
    "DO $body$ BEGIN IF (SELECT datconnlimit FROM pg_database WHERE datname = current_database()) < 0 THEN EXECUTE "
    "format('ALTER DATABASE %I CONNECTION LIMIT {sessions}', current_database()); END IF; END $body$"
)
_NOW = r"""
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
"""
_KEPT = """
DROP TRIGGER IF EXISTS keep ON axiscal.{table};
DROP TRIGGER IF EXISTS keep_all ON axiscal.{table};
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
GRANT EXECUTE ON FUNCTION axiscal.append, axiscal.enter, axiscal.saw TO axiscal_measurer;
"""
ROLES = "axiscal_reader", "axiscal_measurer"
"""Who may read, and who may read and add; a person's account is made a member of one: GRANT axiscal_reader TO anna."""


def prepare(database: Database) -> bool:
    """Make a database a store, or one of an earlier form one of this; False where it is one.  Raises RecordError."""
    there = bool(database.select("SELECT to_regclass('axiscal.form') IS NOT NULL")[0][0])
    form = _form(database) if there else 0
    if form >= FORM:
        refuse_other(database)
        return False

    def made() -> None:
        for role in ROLES:
            database.select(_ROLE.format(role=role))
        if not there:
            _make(database, _FIRST, "campaigns", "events")
        quotas = _NOW.replace("{longest}", str(_LONGEST)).replace("{most}", str(_MOST))
        _make(database, quotas, "seen", "aside")
        database.select(_LIMIT.format(sessions=_SESSIONS))
        database.select(_RIGHTS)

    database.transaction(made)
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
        database.select(each)


def _form(database: Database) -> int:
    """Return the form of a store; one without is as new as can be."""
    form = database.select("SELECT max(number) FROM axiscal.form")[0][0]
    return FORM + 1 if form is None else int(form)


def quarantined(database: Database, campaign: str, first: int) -> int:
    """Set the events of a campaign from one on aside, as the owner, and return how many; raises RecordError."""
    asked = "SELECT axiscal.quarantine(CAST(:campaign AS uuid), CAST(:first AS bigint))"
    return int(database.select(asked, campaign=campaign, first=first)[0][0])
