-- The results of parts: every message, and the newest one of each part.
CREATE TABLE part (
    time timestamptz NOT NULL,
    machine text NOT NULL,
    part bigint NOT NULL,
    number bigint,
    program bigint,
    "order" bigint,
    ended text,
    cycle_s double precision,
    size_mm double precision,
    nominal_mm double precision,
    min_mm double precision,
    max_mm double precision,
    verdict text,
    is_bad boolean,
    since_dressing bigint,
    wheel_mm double precision,
    alarms text
);
SELECT create_hypertable('part', 'time');
CREATE INDEX part_of_machine ON part (machine, part);
-- A part that is told again, or whose size is typed later, has the same number.
CREATE VIEW parts AS
    SELECT DISTINCT ON (machine, part) * FROM part ORDER BY machine, part, time DESC;
