-- 0007: what is shared with other stores: which reports' paths were retired, here or elsewhere, in
-- the order in which that became known. Applied once, in one transaction; see 0001. Once released,
-- never edited.

-- Also of reports that are not here: their paths are retired when they come. What was retired
-- before this schema is not in it: the rows of paths may be damaged, nothing reads them here.
CREATE TABLE retired_report (
  id           INTEGER PRIMARY KEY,  -- grows
  report_uuid  BLOB NOT NULL UNIQUE CHECK (length(report_uuid) = 16),
  retired_ms   INTEGER NOT NULL CHECK (retired_ms > 0)
) STRICT;

-- Attempts whose content another one had brought already, by that one's path: who retires the path
-- names all its reports. Only of these, so that other reports write no page more.
CREATE TABLE same_content (
  path_id      INTEGER NOT NULL,
  report_uuid  BLOB NOT NULL CHECK (length(report_uuid) = 16),
  PRIMARY KEY (path_id, report_uuid)
) STRICT, WITHOUT ROWID;
