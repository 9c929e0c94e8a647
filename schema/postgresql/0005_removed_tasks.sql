-- 0005: tasks are removed, and renamed.

-- How many attempts a task had when it was removed: with more it is listed again. NULL: it was not removed.
ALTER TABLE task ADD COLUMN removed_attempts bigint CHECK (removed_attempts >= 0);

-- Names that tasks have had before.
CREATE TABLE former_task (
  name        text COLLATE "C" PRIMARY KEY CHECK (length(name) BETWEEN 1 AND 128),
  changed_in  xid8 NOT NULL DEFAULT pg_current_xact_id()
);
