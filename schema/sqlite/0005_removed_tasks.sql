-- 0005: tasks are removed, and renamed.

-- How many attempts a task had when it was removed: with more it is listed again. NULL: it was not removed.
ALTER TABLE task ADD COLUMN removed_attempts INTEGER CHECK (removed_attempts >= 0);
