-- 0003: what a query cost in processor time, and on how fast a machine.

-- With everything that guidance costs; 0: unknown, as in all attempts from before.
ALTER TABLE attempt ADD COLUMN processor_time_s double precision NOT NULL DEFAULT 0
  CHECK (processor_time_s >= 0);
-- To the reference machine, as its client measured it (proto/evidence/machine_speed); 0: unknown.
ALTER TABLE attempt ADD COLUMN machine_speed double precision NOT NULL DEFAULT 0
  CHECK (machine_speed >= 0);
