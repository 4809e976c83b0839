//! Production: the finished parts, and the orders that they count for.
//! Source: spec B6, K4.5, K7.2.

use super::hours::HourLog;
use super::wheel_list::WheelList;
use super::{Edited, Panel, Parts};
use crate::controller::plant::Plant;
use crate::controller::power_on::PowerOnState;
use crate::controller::storage_request::StorageRequest;
use crate::defs::equipment::Equipment;
use crate::defs::hour_record::HourRecord;
use crate::defs::param;
use crate::defs::part_record::{MAX_PART_ALARMS, PartHistory, PartRecord};
use crate::defs::part_verdict::PartVerdict;
use crate::defs::production_order::{
    MAX_ORDERS, ORDER_NUMBERS, ORDER_TARGETS, OrderState, OrderValues, ProductionOrder,
};
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::part_result::PartResult;
use crate::link::production::{OrderCommand, OrderPage, OrderProposal, PartInspection, ProductionView, ProposalCheck};
use crate::link::snapshot::Tone;
use crate::units::Micros;

const NO_ORDER: Text = Text::new("没有这个订单", "there is no such order");
const IS_ACTIVE: Text =
    Text::new("订单正在进行：先结束或换一个", "the order is active: close it or start another one first");
const IS_BEGUN: Text =
    Text::new("订单已有工件，程序不能改", "the order has parts already: its program cannot be changed");
const IS_FULL: Text = Text::new("订单已满：先删除结束的", "the list is full: delete closed orders first");
const IN_RUN: Text = Text::new("程序运行中，不能换程序", "a program runs: the program cannot be changed");
const VALUES_IN_RUN: Text =
    Text::new("程序运行中，不能换数值", "a program runs: the values of its page cannot be changed by an order");
const NO_PROGRAM: Text = Text::new("没有这个程序", "there is no such program");
const IS_PROPOSED: Text = Text::new("先接受车间的订单", "accept the order of the shop first");
const IS_CHANGED: Text = Text::new("车间改了订单，再看一次", "the shop has changed the order: look at it again");
const NOT_PROPOSED: Text = Text::new("订单已接受", "the order is accepted already");
const IS_COMPLETE: Text = Text::new("件数已完成：先加大目标", "all parts are made: raise the target first");

/// From the end of a part until its order is looked at: a simulated machine measures the part meanwhile.
const ANNOUNCE_DELAY: Micros = Micros::from_millis(20);

/// Finished parts, orders, and the hours of the machine.
#[derive(Default)]
pub struct Production {
    parts: PartHistory,
    /// Serial number of the last part, and its hour.
    last_count: u64,
    last_hour: Option<u64>,
    /// End of the last cycle, and the part that it has made.
    last_cycle: Option<(Micros, u64)>,
    /// When a part was counted last.
    counted_at: Option<Micros>,
    /// The run that has counted the last part goes on: its end says more of that part.
    is_open: bool,
    /// Serial number of the newest alarm at the last part, or at power-on.
    seen_alarm: u64,
    /// By their numbers.
    orders: Vec<ProductionOrder>,
    /// When the active order is looked at, and number and target of the one that was announced.
    announce_at: Option<Micros>,
    announced: Option<(u32, u32)>,
    pub(super) hours: HourLog,
}

impl Production {
    /// As kept since the last power-off.
    pub fn at_power_on(retained: &PowerOnState, now: Micros) -> Self {
        let mut kept = retained.parts.clone();
        kept.sort_by_key(|part| part.count);
        let last_count = kept.last().map_or(0, |part| part.count);
        let mut orders = Vec::with_capacity(MAX_ORDERS);
        orders.extend_from_slice(&retained.orders);
        let hours = HourLog::at_power_on(&retained.hours, now);
        let seen_alarm = retained.alarm_history.iter().map(|alarm| alarm.count).max().unwrap_or(0);
        let parts = PartHistory::new(kept, now.0 + 1);
        Self { parts, last_count, seen_alarm, orders, hours, ..Self::default() }
    }

    /// Writes the view.
    pub fn write_view(&self, wheels: &WheelList, out: &mut ProductionView) {
        wheels.write_view(&mut out.wheels);
        out.parts.copy_from(&self.parts);
        out.hours.copy_from(self.hours.history());
        out.downtime_reason = self.hours.downtime_reason();
        if out.orders != self.orders {
            out.orders.clone_from(&self.orders);
        }
    }

    /// When a part was counted last.
    pub const fn last_counted(&self) -> Option<Micros> {
        self.counted_at
    }

    fn find(&self, number: u32) -> Option<ProductionOrder> {
        self.orders.iter().find(|order| order.number == number).copied()
    }

    fn active(&self) -> Option<ProductionOrder> {
        self.orders.iter().find(|order| order.state == OrderState::Active).copied()
    }

    /// Enters an order, or changes the one of its number; stores it.
    fn set(&mut self, plant: &mut Plant, order: ProductionOrder) {
        match self.orders.iter_mut().find(|known| known.number == order.number) {
            Some(known) => *known = order,
            None => {
                let place = self.orders.partition_point(|known| known.number < order.number);
                self.orders.insert(place, order);
            }
        }
        plant.store(StorageRequest::Order(order.number, Some(order)));
        self.announce_at = Some(plant.now + ANNOUNCE_DELAY);
    }

    /// Follows the run: without one nothing more is said of the last part.
    pub const fn follow_run(&mut self, runs: bool) {
        self.is_open &= runs;
    }

    /// The alarms that were raised since the part before, the newest first.
    fn alarms_since_last_part(&mut self, plant: &Plant) -> [u16; MAX_PART_ALARMS] {
        let history = plant.alarms.history();
        let newest = history.last().map_or(0, |alarm| alarm.count);
        let seen = std::mem::replace(&mut self.seen_alarm, newest);
        let raised = history.iter().rev().take_while(|alarm| alarm.count > seen);
        let mut numbers = [0; MAX_PART_ALARMS];
        numbers.iter_mut().zip(raised).for_each(|(place, alarm)| *place = alarm.number);
        numbers
    }

    /// A part is made: it is recorded, and counts for the active order if that has its program.
    pub fn add_part(&mut self, plant: &mut Plant, part: &PartResult) {
        if self.is_open {
            // The part before it, of the same run, is all that it will be.
            self.look_at_order(plant);
        }
        let order = self.active().filter(|order| order.program == part.program);
        self.last_count += 1;
        (self.counted_at, self.is_open) = (Some(plant.now), true);
        let record = PartRecord {
            count: self.last_count,
            number: part.number,
            program: part.program,
            order: order.map_or(0, |order| order.number),
            ended: plant.date,
            cycle_seconds: part.times.seconds,
            size: part.judged_size(None).map(|size| size.mm()),
            limits: limits_of(part),
            verdict: part.verdict(None),
            since_dressing: plant.params.get(param::PARTS_SINCE_DRESSING) as u32,
            wheel_mm: (!plant.kind.row().has(Equipment::MainSpindle)).then(|| plant.params.get(param::WHEEL_DIAMETER)),
            alarms: self.alarms_since_last_part(plant),
        };
        self.parts.push(record);
        plant.store(StorageRequest::Part(record));
        self.last_hour = self.hours.hour();
        self.hours.count_part(plant, self.last_hour, |hour| *hour_count(hour, record.verdict) += 1);
        let Some(mut order) = order else { return };
        *count_of(&mut order, record.verdict) += 1;
        self.set(plant, order);
    }

    /// A cycle has ended that has counted some parts: its end says more of the last one. Where programs cannot count (lathe,
    /// 802D), it makes a part of the active order.
    pub fn end_cycle(&mut self, plant: &mut Plant, part: &PartResult, counted: u32) {
        let by_itself = !plant.kind.row().dialect.is_kt830();
        if counted == 0 && by_itself && self.active().is_some_and(|order| order.program == part.program) {
            self.add_part(plant, part);
        } else if counted == 0 {
            return;
        }
        self.is_open = false;
        // A simulated machine measures it now.
        self.announce_at = self.announce_at.map(|_| plant.now + ANNOUNCE_DELAY);
        self.last_cycle = Some((part.ended_at, self.last_count));
        if let Some(record) = self.parts.entries_mut().last_mut() {
            (record.limits, record.ended) = (limits_of(part), plant.date);
            if counted == 1 {
                record.cycle_seconds = part.times.seconds;
            }
        }
        let size = part.judged_size(None).map(|size| size.mm());
        self.judge_part(plant, part.ended_at, (size, part.verdict(None)));
    }

    /// The simulated machine has measured the part of a cycle.
    pub fn inspect(&mut self, plant: &mut Plant, found: PartInspection) {
        self.judge_part(plant, found.ended_at, (found.size, found.verdict));
    }

    /// Size and verdict of the part of the last cycle are known now. What has spoilt it has spoilt it.
    pub fn judge_part(&mut self, plant: &mut Plant, ended_at: Micros, (size, verdict): (Option<f64>, PartVerdict)) {
        let Some((_, count)) = self.last_cycle.filter(|(end, _)| *end == ended_at) else { return };
        let Some(record) = self.parts.entries_mut().iter_mut().rev().find(|part| part.count == count) else { return };
        let before = record.verdict;
        let verdict = if matches!(before, PartVerdict::Spoilt(_)) { before } else { verdict };
        (record.verdict, record.size) = (verdict, size);
        let record = *record;
        plant.store(StorageRequest::Part(record));
        if before.is_bad() == verdict.is_bad() {
            return;
        }
        let hour = if count == self.last_count { self.last_hour } else { self.hours.known_hour(record.ended) };
        self.hours.count_part(plant, hour, |hour| {
            let counted = hour_count(hour, before);
            *counted = counted.saturating_sub(1);
            *hour_count(hour, verdict) += 1;
        });
        let Some(mut order) = self.find(record.order).filter(|order| order.has(&record)) else { return };
        let counted = count_of(&mut order, before);
        *counted = counted.saturating_sub(1);
        *count_of(&mut order, verdict) += 1;
        self.set(plant, order);
    }

    /// Looks at the order once its last part is known.
    pub fn announce(&mut self, plant: &mut Plant) {
        if !self.is_open && self.announce_at.is_some_and(|at| plant.now >= at) {
            self.look_at_order(plant);
        }
    }

    /// Says once when the active order is complete.
    fn look_at_order(&mut self, plant: &mut Plant) {
        self.announce_at = None;
        let Some(order) = self.active().filter(ProductionOrder::is_complete) else { return self.announced = None };
        let ProductionOrder { number, good, target, .. } = order;
        if self.announced.replace((number, target)) != Some((number, target)) {
            let words =
                phrase!("订单 {number} 完成：{good} 件", "order {number} is complete: {good} parts", number, good);
            plant.show(words, Tone::Warning);
        }
    }
}

/// Nominal, least and greatest size of a part, mm.
fn limits_of(part: &PartResult) -> Option<[f64; 3]> {
    part.nominal.and_then(|nominal| nominal.limits.map(|(low, high)| [nominal.mm, low, high]))
}

/// The count of an order that a part of this verdict belongs to.
const fn count_of(order: &mut ProductionOrder, verdict: PartVerdict) -> &mut u32 {
    if verdict.is_bad() { &mut order.bad } else { &mut order.good }
}

/// The same of an hour.
const fn hour_count(hour: &mut HourRecord, verdict: PartVerdict) -> &mut u32 {
    if verdict.is_bad() { &mut hour.bad } else { &mut hour.good }
}

impl Panel {
    /// What the operator does with the list of orders.
    pub(super) fn handle_order_command(&mut self, parts: &mut Parts<'_>, command: OrderCommand) -> Edited {
        match command {
            OrderCommand::Enter(entered) => self.enter_order(parts, entered),
            OrderCommand::Accept(shown) => {
                let number = shown.number;
                let order = self.production.find(number).ok_or(NO_ORDER)?;
                if order.state != OrderState::Proposed {
                    return Err(NOT_PROPOSED.into());
                }
                if OrderProposal::from(&order) != shown {
                    return Err(IS_CHANGED.into());
                }
                self.production.set(parts.plant, ProductionOrder { state: OrderState::Waiting, ..order });
                Ok(phrase!("订单 {number} 已接受", "order {number} accepted", number))
            }
            OrderCommand::Start { number, takes_values } => self.start_order(parts, number, takes_values),
            OrderCommand::Close(number) => {
                let order = self.production.find(number).ok_or(NO_ORDER)?;
                if order.state == OrderState::Proposed {
                    return Err(IS_PROPOSED.into());
                }
                self.production.set(parts.plant, ProductionOrder { state: OrderState::Closed, ..order });
                let (good, target) = (order.good, order.target);
                Ok(phrase!(
                    "订单 {number} 结束：{good} / {target}",
                    "order {number} closed: {good} of {target}",
                    number,
                    good,
                    target
                ))
            }
            OrderCommand::Delete(number) => {
                let order = self.production.find(number).ok_or(NO_ORDER)?;
                if order.state == OrderState::Active {
                    return Err(IS_ACTIVE.into());
                }
                self.production.orders.retain(|order| order.number != number);
                parts.plant.store(StorageRequest::Order(number, None));
                Ok(phrase!("订单 {number} 已删除", "order {number} deleted", number))
            }
        }
    }

    /// A new order, or another program or target of a known one.
    fn enter_order(&mut self, parts: &mut Parts<'_>, entered: OrderProposal) -> Edited {
        let OrderProposal { number, program, target, .. } = entered;
        let (least, most) = (*ORDER_NUMBERS.start(), *ORDER_NUMBERS.end());
        if !ORDER_NUMBERS.contains(&number) {
            return Err(phrase!(
                "订单号应为 {least}–{most}",
                "an order has a number from {least} to {most}",
                least,
                most
            ));
        }
        let (least, most) = (*ORDER_TARGETS.start(), *ORDER_TARGETS.end());
        if !ORDER_TARGETS.contains(&target) {
            return Err(phrase!("件数应为 {least}–{most}", "the parts of an order are {least} to {most}", least, most));
        }
        if parts.plant.work.programs.get(program).is_none() {
            return Err(NO_PROGRAM.into());
        }
        let before = self.production.find(number);
        if before.is_none() && self.production.orders.len() >= MAX_ORDERS {
            return Err(IS_FULL.into());
        }
        if before.is_some_and(|order| order.state == OrderState::Proposed && order.values != entered.values) {
            return Err(IS_CHANGED.into());
        }
        if let Some(order) = before.filter(|order| order.program != program) {
            if order.made() > 0 {
                return Err(IS_BEGUN.into());
            }
            if order.state == OrderState::Active {
                return Err(IS_ACTIVE.into());
            }
        }
        let after = self.production.last_count;
        // Values are those of a page: another program has another one.
        let values =
            before.filter(|order| order.program == program).map_or_else(OrderValues::default, |order| order.values);
        let state = OrderState::Waiting;
        let fresh = ProductionOrder { number, program, target, good: 0, bad: 0, state, after, values };
        // Entered by the operator, a proposed order is accepted.
        let entered = before.filter(|order| order.state != OrderState::Proposed).unwrap_or(fresh);
        self.production.set(parts.plant, ProductionOrder { program, target, values, ..entered });
        let title = parts.plant.program_title(program);
        Ok(phrase!(
            "订单 {number}：{title}，{target} 件",
            "order {number}: {title}, {target} parts",
            number,
            title,
            target
        ))
    }

    /// The shop proposes an order: it stands in the list until the operator has decided. A proposal that cannot be is
    /// left aside; the list that goes back does not have it.
    pub(super) fn propose_order(&mut self, parts: &mut Parts<'_>, proposal: OrderProposal) {
        let OrderProposal { number, program, target, values } = proposal;
        let has_program = parts.plant.work.programs.get(program).is_some();
        let orders = self.production.orders.as_slice();
        if proposal.refusal(ProposalCheck { orders, has_program, page: self.order_page(parts) }).is_some() {
            return;
        }
        if self.production.find(number).is_some_and(|known| OrderProposal::from(&known) == proposal) {
            return;
        }
        let after = self.production.last_count;
        let state = OrderState::Proposed;
        let order = ProductionOrder { number, program, target, good: 0, bad: 0, state, after, values };
        self.production.set(parts.plant, order);
        // What the operator is warned of is more than that.
        if parts.plant.outbox.message.tone == Tone::Info {
            let title = parts.plant.program_title(program);
            parts.plant.show_note(phrase!(
                "车间订单 {number}：{title}，{target} 件，在生产页接受",
                "order {number} from the shop: {title}, {target} parts, accept it on page PRODUCTION",
                number,
                title,
                target
            ));
        }
    }

    /// Whether an order can be started now.
    fn check_start(&self, parts: &Parts<'_>, order: &ProductionOrder, takes_values: bool) -> Result<(), LocalizedText> {
        if order.state == OrderState::Proposed {
            return Err(IS_PROPOSED.into());
        }
        if order.is_complete() {
            return Err(IS_COMPLETE.into());
        }
        if parts.plant.work.programs.get(order.program).is_none() {
            return Err(NO_PROGRAM.into());
        }
        if !takes_values {
            return Ok(());
        }
        if parts.program.is_open() {
            return Err(VALUES_IN_RUN.into());
        }
        OrderProposal::from(order).refusal_of_values(self.order_page(parts)).map_or(Ok(()), Err)
    }

    fn order_page<'a>(&'a self, parts: &'a Parts<'_>) -> OrderPage<'a> {
        OrderPage { kind: parts.plant.kind, screens: &self.screens, params: &parts.plant.params }
    }

    /// The parts count for this order from now on; its program becomes the current one, and its values those of the page if
    /// the operator takes them.
    fn start_order(&mut self, parts: &mut Parts<'_>, number: u32, takes_values: bool) -> Edited {
        let order = self.production.find(number).ok_or(NO_ORDER)?;
        let takes_values = takes_values && !order.values.is_empty();
        self.check_start(parts, &order, takes_values)?;
        let mut warning = None;
        if order.program != parts.plant.execution.current_program {
            if parts.program.is_open() {
                return Err(IN_RUN.into());
            }
            self.load_program(parts, order.program);
            let message = &parts.plant.outbox.message;
            warning = (message.tone == Tone::Warning).then(|| message.text.clone());
        }
        if takes_values {
            // A restart in preparation has the values of before.
            parts.program.abandon_restart();
            for value in order.values.iter() {
                if !parts.program.set_variable(parts.plant, value.variable, Some(value.number)) {
                    return Err(parts.plant.outbox.message.text.clone());
                }
            }
        }
        if let Some(other) = self.production.active().filter(|other| other.number != number) {
            self.production.set(parts.plant, ProductionOrder { state: OrderState::Waiting, ..other });
        }
        self.production.set(parts.plant, ProductionOrder { state: OrderState::Active, ..order });
        let (title, left) = (parts.plant.program_title(order.program), order.left());
        // What load_program warns of (a program of another kind of machine) is more than the start.
        let taken = if takes_values { order.values.iter().count() } else { 0 };
        Ok(warning.unwrap_or_else(|| {
            if taken > 0 {
                return phrase!(
                    "订单 {number} 开始：{title}，还有 {left} 件，采用 {taken} 个数值",
                    "order {number} started: {title}, {left} parts to make, {taken} values taken",
                    number,
                    title,
                    left,
                    taken
                );
            }
            phrase!(
                "订单 {number} 开始：{title}，还有 {left} 件",
                "order {number} started: {title}, {left} parts to make",
                number,
                title,
                left
            )
        }))
    }
}
