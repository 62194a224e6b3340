-- What a store has begun with since its first form.

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
