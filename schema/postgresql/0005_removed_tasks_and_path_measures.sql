-- 0005: tasks are removed, and renamed; paths are measured by those who planned them.

-- How many attempts a task had when it was removed: with more it is listed again. NULL: it was not removed.
ALTER TABLE task ADD COLUMN removed_attempts bigint CHECK (removed_attempts >= 0);

-- Names that tasks have had before.
CREATE TABLE former_task (
  name        text COLLATE "C" PRIMARY KEY CHECK (length(name) BETWEEN 1 AND 128),
  changed_in  xid8 NOT NULL DEFAULT pg_current_xact_id()
);

-- Of the solution: the way of the transfer frame, and the least clearance; 0: not measured.
ALTER TABLE attempt ADD COLUMN hand_length_m double precision NOT NULL DEFAULT 0 CHECK (hand_length_m >= 0);
ALTER TABLE attempt ADD COLUMN least_clearance_m double precision NOT NULL DEFAULT 0 CHECK (least_clearance_m >= 0);

-- The solved attempts in each sampling mode of which time and path were measured, and sums over them: processor time of
-- everything on a machine of speed 1, length in joint units, and the two above.
ALTER TABLE experience ADD COLUMN guided_measured bigint NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN guided_time_s double precision NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN guided_length double precision NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN guided_hand_length_m double precision NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN guided_clearance_m double precision NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_measured bigint NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_time_s double precision NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_length double precision NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_hand_length_m double precision NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_clearance_m double precision NOT NULL DEFAULT 0;
