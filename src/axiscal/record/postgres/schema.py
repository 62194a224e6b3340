"""The tables of a store, what they refuse, and who may do what.

Nobody changes or deletes an event, its owner included: a trigger refuses it. What is inserted has to follow: the next
number of its campaign, and the hash chained over what stands before it, which the server computes itself.
"""

from __future__ import annotations

from axiscal.exceptions import RecordError
from axiscal.record.log import EMPTY
from axiscal.record.postgres.database import Database

FORM = 1
"""Of the tables."""
_TABLES = f"""
CREATE SCHEMA axiscal;
CREATE TABLE axiscal.form (number integer PRIMARY KEY);
INSERT INTO axiscal.form VALUES ({FORM});
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
_KEPT = """
CREATE TRIGGER keep BEFORE UPDATE OR DELETE ON axiscal.{table} FOR EACH ROW EXECUTE FUNCTION axiscal.refuse();
CREATE TRIGGER keep_all BEFORE TRUNCATE ON axiscal.{table} FOR EACH STATEMENT EXECUTE FUNCTION axiscal.refuse();
"""
_ROLE = "DO $body$ BEGIN CREATE ROLE {role} NOLOGIN; EXCEPTION WHEN duplicate_object THEN NULL; END $body$"
_RIGHTS = """
REVOKE ALL ON SCHEMA axiscal FROM PUBLIC;
GRANT USAGE ON SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
GRANT SELECT ON ALL TABLES IN SCHEMA axiscal TO axiscal_reader, axiscal_measurer;
GRANT INSERT ON axiscal.campaigns, axiscal.events TO axiscal_measurer;
"""
ROLES = "axiscal_reader", "axiscal_measurer"
"""Who may read, and who may read and add; a person's account is made a member of one: GRANT axiscal_reader TO anna."""


def prepare(database: Database) -> bool:
    """Make a database a store; False where it is one already.  Raises RecordError."""
    if _there(database):
        refuse_newer(database)
        return False
    with database.transaction("tables"):
        for role in ROLES:
            database.rows(_ROLE.format(role=role))
        for script in (_TABLES, *(_KEPT.format(table=table) for table in ("campaigns", "events")), _RIGHTS):
            database.rows(script)
    return True


def refuse_newer(database: Database) -> None:
    """Raise RecordError for a database that is no store, or one of a newer axiscal."""
    form = database.rows("SELECT max(number) FROM axiscal.form")[0][0]
    if form is None or form > FORM:
        what = f"This store was made by a newer axiscal (form {form}; this one knows {FORM})"
        raise RecordError(what, "Install the newer version; nothing was changed", database.address.shown)


def _there(database: Database) -> bool:
    return bool(database.rows("SELECT to_regclass('axiscal.form') IS NOT NULL")[0][0])
