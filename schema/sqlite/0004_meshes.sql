-- 0004: meshes of robots travel.

-- The content of a mesh, once for all robots whose robot_geometry.mesh_solids names it; a content that
-- no registered robot names goes. A row refers to no other; one that is damaged is dropped, and the
-- next registration of its robot is asked for it.
CREATE TABLE mesh (
  id          INTEGER PRIMARY KEY,
  digest      BLOB NOT NULL UNIQUE CHECK (length(digest) = 32),  -- SHA-256 of the canonical bytes
  bytes       INTEGER NOT NULL CHECK (bytes BETWEEN 32 AND 4194304),  -- before compression
  crc32c      INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),  -- of the payload
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
  payload     BLOB NOT NULL CHECK (length(payload) BETWEEN 1 AND 524288)  -- the canonical bytes as zlib
) STRICT;
