-- 0006: the audit log: who had what done to the store, and what was refused. Applied once, in one
-- transaction; see 0001. Once released, never edited.

CREATE TABLE audit (
  id         INTEGER PRIMARY KEY,  -- grows
  time_ms    INTEGER NOT NULL,
  name       TEXT NOT NULL CHECK (length(name) <= 64),     -- in the certificate; '': none
  role       TEXT NOT NULL CHECK (length(role) <= 64),     -- of the certificate; '': none
  client     TEXT NOT NULL CHECK (length(client) <= 128),  -- the name, or the participant
  is_local   INTEGER NOT NULL CHECK (is_local IN (0, 1)),
  verb       TEXT NOT NULL CHECK (length(verb) BETWEEN 1 AND 64),
  target     TEXT NOT NULL CHECK (length(target) <= 1024),
  outcome    INTEGER NOT NULL CHECK (outcome BETWEEN 1 AND 4),  -- 1 begun, 2 done, 3 refused, 4 failed
  was        TEXT NOT NULL CHECK (length(was) <= 2048),
  became     TEXT NOT NULL CHECK (length(became) <= 2048),
  message    TEXT NOT NULL CHECK (length(message) <= 2048)
) STRICT;
CREATE INDEX audit_by_name ON audit (name, id);

-- Entries are added, never changed or removed.
CREATE TRIGGER audit_keeps_its_rows BEFORE UPDATE ON audit
BEGIN SELECT RAISE(ABORT, 'the audit log is append-only'); END;
CREATE TRIGGER audit_keeps_all_rows BEFORE DELETE ON audit
BEGIN SELECT RAISE(ABORT, 'the audit log is append-only'); END;
-- REPLACE deletes without the trigger above.
CREATE TRIGGER audit_replaces_no_row BEFORE INSERT ON audit
WHEN EXISTS (SELECT 1 FROM audit WHERE id = NEW.id)
BEGIN SELECT RAISE(ABORT, 'the audit log is append-only'); END;
